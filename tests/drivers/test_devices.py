"""`stiction devices` over a copy of /sys and /dev: which driver, what to type, what is in the way."""
import json
import os
import shutil
import subprocess
import sys
import tempfile

PROGRAM = os.environ["STICTION"]
CAP = bytes.fromhex("05010908a100c0")       # multi-axis controller
PAD = bytes.fromhex("05010905a100c0")       # gamepad
KEYBOARD = bytes.fromhex("05010906a100c0")
MOTION = bytes.fromhex("05010900a100c0")    # the Hydra's motion side
failures = 0


def check(name, good, shown=""):
    global failures
    failures += not good
    print(("ok   " if good else "FAIL ") + name + ("" if good else f": {shown}"))


def put(path, data=b""):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as f:
        f.write(data if isinstance(data, bytes) else data.encode())


class Root:
    def __init__(self):
        self.path = tempfile.mkdtemp(prefix="stiction-devices-")
        os.chmod(self.path, 0o755)

    def hid(self, n, bus, vendor, product, name, descriptor, serial="", mode=0o666):
        folder = f"{self.path}/sys/class/hidraw/hidraw{n}/device"
        put(f"{folder}/uevent",
            f"HID_ID={bus:04X}:{vendor:08X}:{product:08X}\nHID_NAME={name}\nHID_UNIQ={serial}\n")
        put(f"{folder}/report_descriptor", descriptor)
        self.node(f"hidraw{n}", mode)

    def node(self, name, mode):
        put(f"{self.path}/dev/{name}")
        os.chmod(f"{self.path}/dev/{name}", mode)

    def tty(self, name, kind=None, adapter=None, mode=0o666):
        folder = f"{self.path}/sys/class/tty/{name}"
        device = f"{self.path}/sys/devices/usb1/1-1/1-1:1.0/{name}" if adapter else f"{self.path}/sys/devices/{name}"
        os.makedirs(device)
        os.makedirs(folder)
        os.symlink(device, f"{folder}/device")
        if kind is not None:
            put(f"{folder}/type", f"{kind}\n")
        if adapter:
            put(f"{self.path}/sys/devices/usb1/1-1/idVendor", f"{adapter[0]:04x}\n")
            put(f"{self.path}/sys/devices/usb1/1-1/idProduct", f"{adapter[1]:04x}\n")
            put(f"{self.path}/sys/devices/usb1/1-1/product", adapter[2])
        self.node(name, mode)

    def run(self, *more, **how):
        return subprocess.run([PROGRAM, "devices", "--root", self.path, *more], capture_output=True, text=True,
                              timeout=60, **how)

    def devices(self):
        done = self.run("--json")
        check("JSON ends with 0", done.returncode == 0, done.stderr)
        return {os.path.basename(d["path"]): d for d in json.loads(done.stdout)["devices"]}

    def remove(self):
        shutil.rmtree(self.path)


def nothing():
    root = Root()
    done = root.run()
    check("nothing connected ends with 0", done.returncode == 0, done.stderr)
    check("... and says what to do", "No tracker is connected. Plug one in" in done.stdout and
          "--device trace:file=TRACE" in done.stdout, done.stdout)
    check("... and lists the drivers", "  spacemouse " in done.stdout and "  logitech " in done.stdout, done.stdout)
    check("... without advice on permissions", "udevadm" not in done.stdout, done.stdout)
    keys = root.run("--drivers").stdout
    check("--drivers tells their keys", "    hand       left or right" in keys and "    port " in keys, keys)
    keys = json.loads(root.run("--drivers", "--json").stdout)
    check("... also as JSON", list(keys) == ["drivers"] and any(d["name"] == "hydra" for d in keys["drivers"]), keys)
    root.remove()


def several():
    root = Root()
    root.hid(0, 3, 0x046d, 0xc626, "3Dconnexion SpaceNavigator", CAP)
    root.hid(1, 3, 0x1532, 0x0300, "Razer Hydra", MOTION)
    root.hid(2, 3, 0x1532, 0x0300, "Razer Hydra", PAD)
    root.hid(3, 3, 0x413c, 0x2113, "Dell Keyboard", KEYBOARD)
    root.hid(4, 5, 0x054c, 0x0ce6, "Wireless Controller", PAD)
    root.tty("ttyS0", kind=4)
    root.tty("ttyS1", kind=0)
    root.tty("ttyUSB0", adapter=(0x0403, 0x6001, "FT232R USB \xff UART\n"))
    root.tty("ttyS10", kind=4)
    found = root.devices()
    told = {name: (d["driver"], d["device"], d["bus"]) for name, d in found.items()}
    dev = root.path + "/dev/"
    check("drivers, texts and buses", told == {
        "hidraw0": ("spacemouse", "spacemouse", "usb"),
        "hidraw1": ("hydra", "hydra", "usb"),
        "hidraw2": ("hydra", "hydra", "usb"),
        "hidraw3": (None, None, "usb"),
        "hidraw4": ("gamepad", "gamepad", "bluetooth"),
        "ttyS0": ("logitech", f"logitech:port={dev}ttyS0", "serial"),
        "ttyS10": ("logitech", f"logitech:port={dev}ttyS10", "serial"),
        "ttyUSB0": ("logitech", f"logitech:port={dev}ttyUSB0", "serial")}, told)
    check("the adapter's numbers and name", (found["ttyUSB0"]["vendor"], found["ttyUSB0"]["product"],
          found["ttyUSB0"]["name"][:10]) == (0x0403, 0x6001, "FT232R USB"), found["ttyUSB0"])
    check("a serial port is not certain", not found["ttyS0"]["certain"] and found["hidraw0"]["certain"])
    done = root.run()
    check("for people", "3Dconnexion SpaceNavigator  (usb 046d:c626" in done.stdout and
          "--device spacemouse\n" in done.stdout and "Not for any driver" in done.stdout, done.stdout)
    os.unlink(f"{root.path}/dev/hidraw0")
    check("a missing node is told", root.devices()["hidraw0"]["state"] == "no node" and
          "nothing at that path" in root.run().stdout)
    root.remove()


def alike():
    root = Root()
    root.hid(0, 3, 0x046d, 0xc626, "SpaceNavigator", CAP)
    root.hid(1, 3, 0x046d, 0xc626, "SpaceNavigator", CAP)
    root.hid(2, 3, 0x256f, 0xc635, "SpaceMouse Compact", CAP, serial="a,b")
    texts = {name: d["device"] for name, d in root.devices().items()}
    check("several of a kind are told apart", texts == {
        "hidraw0": f"spacemouse:path={root.path}/dev/hidraw0",
        "hidraw1": f"spacemouse:path={root.path}/dev/hidraw1",
        "hidraw2": "spacemouse:serial=a\\,b"}, texts)
    root.remove()


def by_name():
    root = Root()
    root.hid(0, 5, 0, 0, "DualSense Wireless Controller", PAD)
    root.hid(1, 5, 0, 0, "SpaceMouse Pro BT", CAP)
    root.hid(2, 3, 0x256f, 0xcfff, "SpaceMouse Next", CAP)
    root.hid(3, 3, 0x256f, 0xc651, "CadMouse, not a SpaceMouse", CAP)
    root.hid(4, 3, 0x1234, 0x5678, "SpaceMouse, says a stranger", CAP)
    root.hid(5, 5, 0x054c, 0x09cc, "Wireless Controller", PAD)
    root.hid(6, 3, 0, 0, "Razer Hydra", MOTION)
    drivers = {name: d["driver"] for name, d in root.devices().items()}
    check("by name where numbers are hidden or new", drivers == {
        "hidraw0": "gamepad", "hidraw1": "spacemouse", "hidraw2": "spacemouse", "hidraw3": None, "hidraw4": None,
        "hidraw5": None, "hidraw6": "hydra"}, drivers)
    root.remove()


def forbidden():
    root = Root()
    root.hid(0, 3, 0x046d, 0xc626, "SpaceNavigator", CAP, mode=0)
    root.hid(1, 3, 0x1532, 0x0300, "Razer Hydra", MOTION, mode=0)
    root.tty("ttyS0", kind=4, mode=0)
    how = {"user": 65534} if os.geteuid() == 0 else {}
    try:
        done = root.run(**how)
    except PermissionError:
        print("skip permissions: an ordinary user may not run the program here")
        root.remove()
        return
    out = done.stdout
    check("permissions: ends with 0", done.returncode == 0, done.stderr)
    check("... both paths in one advice", f"No permission for {root.path}/dev/hidraw0, {root.path}/dev/hidraw1." in out,
          out)
    check("... rule file and reload command once",
          out.count("70-stiction.rules") == 1 and out.count("sudo udevadm control --reload") == 1, out)
    check("... the group for serial ports", out.count("sudo usermod -aG ") == 1, out)
    root.remove()


nothing()
several()
alike()
by_name()
forbidden()
sys.exit(1 if failures else 0)
