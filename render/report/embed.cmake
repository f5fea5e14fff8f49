# cmake -DOUT=assets.c "-DASSETS=a;b" -P embed.cmake: the files as constant bytes in one C source.
set(arrays "")
set(table "")
set(number 0)
foreach(path IN LISTS ASSETS)
  get_filename_component(name "${path}" NAME)
  file(READ "${path}" hex HEX)
  string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
  string(APPEND arrays "static const unsigned char asset_${number}[] = {\n${bytes}\n};\n")
  string(APPEND table "  {\"${name}\", asset_${number}, sizeof asset_${number}},\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUT}"
  "#include \"assets.h\"\n\n${arrays}\n"
  "const stic_asset stic_assets[] = {\n${table}};\nconst int stic_asset_count = ${number};\n")
