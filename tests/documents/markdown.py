"""Fenced blocks, links and paths of Markdown files."""
import re
from dataclasses import dataclass, field

COMMENT = re.compile(r"<!-- (.*) -->$")
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"`([^`\s]+)`")


def list_documents(source):
    return [file for file in sorted(source.rglob("*.md")) if not {"build", ".git"} & set(file.relative_to(source).parts)]


@dataclass
class Block:
    line: int
    language: str
    body: list
    remark: str = ""  # of a comment right above
    output: list = field(default=None)  # of a `text` block below a `sh` block


def read_blocks(markdown):
    """All fenced blocks; what a command prints belongs to it."""
    blocks, lines, i = [], markdown.split("\n"), 0
    while i < len(lines):
        if lines[i].startswith("```"):
            end = lines.index("```", i + 1)
            remark = COMMENT.match(lines[i - 1]) if i > 0 else None
            block = Block(i + 1, lines[i][3:], lines[i + 1:end], remark.group(1) if remark else "")
            if block.language == "text":
                if not blocks or blocks[-1].language != "sh" or blocks[-1].output is not None:
                    raise SystemExit(f"line {i + 1}: output without a command")
                blocks[-1].output = block.body
            else:
                blocks.append(block)
            i = end
        i += 1
    return blocks


def read_links(markdown):
    """Targets of links within the repository, without their anchors."""
    targets = (target.split("#")[0] for target in LINK.findall(markdown))
    return [target for target in targets if target and "://" not in target]


def read_paths(markdown, folders):
    """Words in code style that are paths of one of `folders`."""
    return [word for word in CODE.findall(markdown)
            if word.split("/")[0] in folders and "/" in word and not re.search(r"[*…<>{}$]", word)]


def read_sentences(markdown):
    """Sentences of paragraphs and lists, without headings, tables, blocks and remarks; links without their targets."""
    text = re.sub(r"<!--.*?-->", "", markdown, flags=re.DOTALL)
    text = re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    paragraphs = [""]
    for line in map(str.strip, text.split("\n")):
        if not line or line[0] in "|#" or re.match(r"([-*]|\d+\.)\s", line):
            paragraphs.append("")
        if line and line[0] not in "|#":
            paragraphs[-1] += " " + line
    return [sentence for paragraph in paragraphs for sentence in re.split(r"(?<=[.!?])\s+(?=[A-Z`*\[(])", paragraph)]
