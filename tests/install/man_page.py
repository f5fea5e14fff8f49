#!/usr/bin/env python3
"""Holds the man page against --help: commands, each one's options, measurements, exit codes.

    man_page.py PROGRAM PAGE
"""
import re
import shutil
import subprocess
import sys

program, page = sys.argv[1:]
source = open(page, encoding="utf-8").read()
faults = []


def shown(*arguments):
    return subprocess.run([program, *arguments], check=True, capture_output=True, text=True).stdout


def section(title, level="SH"):
    """The text between a heading and the next of its level or above."""
    end = r"\.SH" if level == "SH" else r"\.S[HS]"
    found = re.search(rf'^\.{level} "?{re.escape(title)}"?\n(.*?)(?=^{end} |\Z)', source, re.M | re.S)
    if not found:
        faults.append(f"there is no section {title}")
    return found.group(1).replace(r"\-", "-") if found else ""


def options_in(text):
    return set(re.findall(r"(?<![\w-])--([a-z][a-z-]*)", text))


def compare(where, help_has, page_has):
    faults.extend(f"{where}: {x} is missing" for x in sorted(help_has - page_has))
    faults.extend(f"{where}: {x} is not in --help" for x in sorted(page_has - help_has))


top = shown("--help")
commands = re.findall(r"^  ([a-z]+) ", top.split("Commands:")[1].split("\n\n")[0], re.M)
compare("COMMANDS", set(commands), set(re.findall(r"^\.SS (.*)$", section("COMMANDS"), re.M)))

every = set()
for command in commands:
    text = shown(command, "--help")
    options = set(re.findall(r"^  (?:-\w, |    )--([a-z][a-z-]*)", text, re.M)) - {"help"}
    compare(command, options, options_in(section(command, "SS")))
    every |= options
    for name in re.findall(r"(?<=\|)[a-z]+|[a-z]+(?=\|)", text.split("\n")[0]):
        if not re.search(rf"^\.B {name}$", section(command, "SS"), re.M):
            faults.append(f"{command}: {name} is missing")

headings = re.findall(r"^\.TP\n(\..*--.*)$", section("OPTIONS"), re.M)
compare("OPTIONS", every, options_in("\n".join(headings)))
if len(headings) != len(every):
    faults.append(f"OPTIONS: {len(headings)} entries for {len(every)} options")

codes = re.findall(r"^  (\d+)  (.*)$", top.split("Exit codes:")[1], re.M)
for code, meaning in codes:
    if f".B {code}\n{meaning}\n" not in section("EXIT STATUS"):
        faults.append(f"EXIT STATUS: {code}, {meaning}, is missing")

if not commands or not every or not codes:
    faults.append("this test no longer understands --help")
if shutil.which("groff"):
    lint = subprocess.run(["groff", "-ww", "-man", "-Tutf8", "-z", page], capture_output=True, text=True)
    faults.extend(lint.stderr.splitlines())
print("\n".join(f"{page}: {fault}" for fault in faults) or f"{len(commands)} commands, {len(every)} options")
sys.exit(1 if faults else 0)
