# Installs those packages of the file `packages` that are missing. Usage: . .ci/packages.sh; need build run ...

# Names of the packages of some purposes that are not installed.
missing() {
  local purpose package
  for purpose in "$@"; do
    for package in $(sed -n "s/^$purpose: //p" packages); do
      [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || echo "$package"
    done
  done
}

install_packages() {
  echo "installing: $*"
  local root=""
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "these packages are needed and neither root nor sudo is there: $*" >&2; return 1; }
    root="sudo"
  fi
  $root apt-get update -qq
  $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

need() {
  local names
  mapfile -t names < <(missing "$@")
  [ "${#names[@]}" = 0 ] || install_packages "${names[@]}"
}

# The same one by one: what cannot be installed is said and done without.
offer() {
  local package
  for package in $(missing "$@"); do
    install_packages "$package" || echo "$package cannot be installed: what needs it is left out"
  done
}
