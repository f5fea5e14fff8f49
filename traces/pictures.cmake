# Makes traces/NAME/picture.png of each trace anew and puts it at the top of its README.md.
# cmake -DPROGRAM=build/stiction -P traces/pictures.cmake

set(here ${CMAKE_CURRENT_LIST_DIR})
file(STRINGS ${here}/pictures.txt lines REGEX "^[^#]")
file(GLOB scenes ${here}/*/scene.yaml)

# The options of the line for a trace.
function(options_of name out)
  set(${out} --at largest-slip PARENT_SCOPE)
  foreach(line IN LISTS lines)
    separate_arguments(words UNIX_COMMAND "${line}")
    list(POP_FRONT words first)
    if(first STREQUAL name)
      set(${out} ${words} PARENT_SCOPE)
    endif()
  endforeach()
endfunction()

# Below the title, unless the page has it somewhere.
function(show_in_readme folder name)
  if(NOT EXISTS ${folder}/README.md)
    return()
  endif()
  file(READ ${folder}/README.md page)
  if(page MATCHES "picture\\.png")
    return()
  endif()
  set(image "![${name}](picture.png)\n")
  string(FIND "${page}" "\n" end)
  if(page MATCHES "^# " AND end GREATER 0)
    math(EXPR after "${end} + 1")
    string(SUBSTRING "${page}" 0 ${after} title)
    string(SUBSTRING "${page}" ${after} -1 rest)
    set(page "${title}\n${image}${rest}")
  else()
    set(page "${image}\n${page}")
  endif()
  file(WRITE ${folder}/README.md "${page}")
endfunction()

foreach(scene IN LISTS scenes)
  get_filename_component(folder ${scene} DIRECTORY)
  get_filename_component(name ${folder} NAME)
  if(NOT EXISTS ${folder}/hand.csv)
    continue() # made on request
  endif()
  options_of(${name} options)
  execute_process(
    COMMAND ${PROGRAM} still ${scene} ${folder}/hand.csv --size 960x540 --quality best ${options}
            --out ${folder}/picture.png
    RESULT_VARIABLE code)
  if(code)
    message(FATAL_ERROR "no picture of ${name}; see its line in traces/pictures.txt")
  endif()
  show_in_readme(${folder} ${name})
  file(SIZE ${folder}/picture.png bytes)
  message(STATUS "traces/${name}/picture.png, ${bytes} bytes")
endforeach()
