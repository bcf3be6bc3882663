"""The reference of all commands, from the help that the programs print."""
import re
import subprocess

SECTION = re.compile(r"^([A-Z][^:]*):$")
# A name, what it takes, and its meaning, which a long name leaves one blank or the next line.
COLUMN = re.compile(r"^  (-\S+(?: [A-Z]{3,}\S*)?(?: \.\.\.)?(?: REQUIRED)?|\S+(?: FILE)?(?: x \d+)?(?: \.\.\.)?(?: REQUIRED)?)(?:\s+(\S.*))?$")


def ask(program, *command):
    return subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True).stdout


def escape(text):
    return text.replace("|", "\\|").replace("<", "&lt;")


def list_rows(lines):
    """(option, meaning) of a section's lines: a long name stands on a line of its own, its meaning below."""
    rows = []
    for line in lines:
        if line.startswith("   ") and rows:
            rows[-1][1] = f"{rows[-1][1]} {line.strip()}".strip()
        elif match := COLUMN.match(line):
            rows.append([match.group(1), match.group(2) or ""])
    return rows


def split_sections(text):
    """Title and lines of each part: options are indented below a title, anything else is prose."""
    sections, title, lines = [], "", []
    for line in text.rstrip().split("\n"):
        if match := SECTION.match(line):
            sections.append((title, lines))
            title, lines = match.group(1), []
        elif title and line and not line.startswith(" "):
            sections.append((title, lines))
            title, lines = "", [line]
        else:
            lines.append(line)
    sections.append((title, lines))
    return [(name, body) for name, body in sections if any(line.strip() for line in body)]


def describe_prose(lines):
    """What is indented is a command line; the rest are sentences."""
    text, block = [], []
    for line in [*lines, ""]:
        if line.startswith(("  ", "Usage: ")):
            block.append(line.strip().removeprefix("Usage: "))
            continue
        if block:
            text += ["", "```text", *block, "```", ""]
            block = []
        text.append(escape(line))
    return text


def describe_command(program, heading, *command):
    """Markdown of one command; the names of its own commands."""
    text, commands = [f"{'#' * (2 if not command else 3)} {heading}", ""], []
    for title, lines in split_sections(ask(program, *command)):
        if title == "Subcommands":
            commands = [row[0] for row in list_rows(lines)]
        elif title.startswith("Example"):
            text += [f"**{title}**", "", *describe_prose(lines)]
        elif title:
            rows = list_rows(lines)
            text += [f"**{title}**", "", "| | |", "| --- | --- |",
                     *(f"| `{name}` | {escape(meaning)} |" for name, meaning in rows), ""]
        else:
            text += describe_prose(lines)
    return text, commands


def describe(programs):
    """The page, for programs by their names."""
    text = ["# Commands", "", "Each command as its own `--help` has it, at the time this manual was built. Installed, the programs are called",
            "`wems-simulate` and `wems-identify`. Recordings are [any of these formats](../../models/recording/README.md), models are",
            "[TOML files](../../models/README.md).", ""]
    for name, path in programs.items():
        body, commands = describe_command(path, f"`{name}`")
        text += body
        for command in commands:
            text += describe_command(path, f"`{name} {command}`", command)[0]
    return "\n".join(text) + "\n"
