# Installs those packages of the file `packages` that are missing. Usage: . .ci/packages.sh; need build run ...
need() {
  local wanted="" missing="" purpose package
  for purpose in "$@"; do wanted="$wanted $(sed -n "s/^$purpose: //p" packages)"; done
  for package in $wanted; do
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
  done
  [ -n "$missing" ] || return 0
  echo "installing:$missing"
  local root=""
  if [ "$(id -u)" != 0 ]; then
    command -v sudo >/dev/null || { echo "these packages are needed and neither root nor sudo is there:$missing" >&2; return 1; }
    root="sudo"
  fi
  $root apt-get update -qq
  # shellcheck disable=SC2086 # a list of names
  $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >/dev/null
}
