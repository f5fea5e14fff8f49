#!/bin/bash
# Boots a real kernel in qemu and lets the real drivers read emulated HID devices there.
#
#   run.sh uhid|run|usb CACHE PROGRAM...
#
# uhid: all emulated devices through /dev/uhid, on Debian's small cloud kernel.
# run: stiction run itself through the life of one of them, on the same kernel.
# usb: a SpaceNavigator as a USB gadget, on Debian's full kernel, with its hid-logitech and udevd.
# PROGRAMs go into the guest under their own names. CACHE keeps the kernels between runs; packages are fetched by
# apt-get download and unpacked, not installed. Exit code 0: passed, 77: cannot run here (says why), 1: failed.
# With CI=true what cannot run has failed.
set -euo pipefail

here=$(cd "$(dirname "$0")" && pwd)
kind=$1 cache=$2
shift 2
readonly PASS=33 # of isa-debug-exit for the byte 16
readonly LIMIT=${STICTION_KERNEL_LIMIT:-240} # s

cannot() {
  echo "skipped: $*"
  [ "${CI:-}" = true ] && exit 1
  exit 77
}

# ---- what is needed -----------------------------------------------------------------------

[ "$(uname -m)" = x86_64 ] || cannot "the emulated kernel is for x86_64 only"
for tool in qemu-system-x86_64 cpio apt-get apt-cache dpkg strings; do
  command -v $tool >/dev/null || cannot "$tool is missing; install qemu-system-x86, cpio, binutils"
done

# The cloud kernel has no Logitech driver, which would refuse a SpaceNavigator that is on no USB bus.
case $kind in
uhid | run)
  meta=linux-image-cloud-amd64 modules="hid hid-generic uhid" packages=busybox-static
  ;;
usb)
  meta=linux-image-amd64 packages="busybox-static udev"
  modules="dummy_hcd usb_f_hid usbhid hid-generic hid-logitech"
  ;;
*)
  echo "usage: run.sh uhid|run|usb CACHE PROGRAM..." >&2
  exit 1
  ;;
esac

# A kernel package's name changes with each release.
kernel=$(apt-cache depends $meta 2>/dev/null | sed -n 's/.*Depends: \(linux-image-[0-9].*\)/\1/p' | head -1)
[ -n "$kernel" ] || cannot "apt knows no $meta; run apt-get update"

fetch() { # PACKAGE: unpacked into CACHE/PACKAGE.d
  local fresh="$cache/$1.part"
  [ -d "$cache/$1.d" ] && return 0
  rm -rf "$fresh"
  mkdir -p "$fresh"
  (cd "$fresh" && apt-get download -qq "$1" 2>&1 && dpkg -x "$1"_*.deb . && rm -f "$1"_*.deb) \
    >"$fresh.log" || return 1
  mv "$fresh" "$cache/$1.d"
}

mkdir -p "$cache"
for package in $kernel $packages; do
  fetch "$package" || cannot "cannot download $package: $(tail -1 "$cache/$package.part.log")"
done

# ---- the guest's files --------------------------------------------------------------------

root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
chmod 755 "$root" # it becomes /, which an ordinary user must be able to enter
mkdir -p "$root"/{bin,dev,proc,sys,tmp,modules,lib64}

declare -A added
count=10
add_module() { # NAME, after what it depends on
  local file name=${1//-/_}
  [ -z "${added[$name]:-}" ] || return 0
  added[$name]=1
  file=$(find "$cache/$kernel.d/lib/modules" -name "${name//_/-}.ko" -o -name "$name.ko" | head -1)
  if [ -z "$file" ]; then
    grep -q "/${name//_/[-_]}\.ko$" "$cache/$kernel.d"/lib/modules/*/modules.builtin && return 0
    cannot "$kernel has no module $1"
  fi
  for needed in $(strings -a "$file" | sed -n 's/^depends=//p' | head -1 | tr , ' '); do
    add_module "$needed"
  done
  cp "$file" "$root/modules/$count-$name.ko"
  count=$((count + 1))
}

add_program() { # FILE, with the libraries it is linked to
  cp "$1" "$root/bin/"
  { ldd "$1" 2>/dev/null || true; } | { grep -o '/[^ ]*' || true; } | while read -r library; do
    mkdir -p "$root$(dirname "$library")"
    cp -Lu "$library" "$root$library"
  done
}

for module in $modules; do
  add_module $module
done
cp "$(find "$cache/busybox-static.d" -path '*bin/busybox' -type f | head -1)" "$root/bin/busybox"
ln -s busybox "$root/bin/sh"
for program in "$@"; do
  add_program "$program"
done
if [ "$kind" = usb ]; then
  add_program "$(find "$cache/udev.d" -path '*bin/udevadm' -type f | head -1)"
  # hidapi's libusb backend reads names with these.
  for file in UTF-16.so gconv-modules.cache; do
    install -D -m 644 -t "$root/usr/lib/x86_64-linux-gnu/gconv" "/usr/lib/x86_64-linux-gnu/gconv/$file"
  done
fi
install -m 755 "$here/guest_init" "$root/init"
install -m 755 "$here/guest_test_$kind" "$root/test"
(cd "$root" && find . | LC_ALL=C sort | cpio --quiet -o -H newc -R 0:0) >"$root.cpio"
trap 'rm -rf "$root" "$root.cpio"' EXIT

# ---- run ----------------------------------------------------------------------------------

# tcg even where /dev/kvm is: its software variants hang in early boot.
code=0
timeout -k 5 "$LIMIT" qemu-system-x86_64 -M pc -accel tcg -m 512 -nodefaults -nographic -no-reboot -serial stdio \
  -device isa-debug-exit,iobase=0xf4,iosize=4 -kernel "$cache/$kernel.d"/boot/vmlinuz-* -initrd "$root.cpio" \
  -append "console=ttyS0 panic=-1 quiet" </dev/null || code=$?
if [ $code != $PASS ]; then
  echo "FAIL: qemu ended with $code, expected $PASS (3: a test failed, 5: a module, 0: panic, 124: no end in $LIMIT s)"
  exit 1
fi
echo "$kind test passed on $kernel"
