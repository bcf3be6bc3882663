"""One page in two forms: Markdown with pictures as files, HTML with everything inside."""
import html
import re


def to_html(text):
    """Escaped, with `code` set as such and a value kept on one line with the error in brackets behind it."""
    text = re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(text))
    return re.sub(r"(\d) (\([-−+0-9.e]+) %\)", "\\1\N{NO-BREAK SPACE}\\2\N{NO-BREAK SPACE}%)", text)


class Page:
    def __init__(self, title):
        self.title, self.parts, self.pictures = title, [], {}

    def heading(self, text, level=2):
        self.parts.append(("heading", level, text))

    def text(self, text):
        self.parts.append(("text", text))

    def table(self, header, rows):
        self.parts.append(("table", header, rows))

    def picture(self, name, svg):
        self.pictures[name] = svg
        self.parts.append(("picture", name))

    def markdown(self):
        out = [f"# {self.title}\n"]
        previous = None
        for part in self.parts:
            if part[0] == "picture" and previous != "picture":
                out.append("")
            if part[0] == "heading":
                out.append(f"\n{'#' * part[1]} {part[2]}\n")
            elif part[0] == "text":
                out.append(part[1] + "\n")
            elif part[0] == "table":
                out.append("| " + " | ".join(part[1]) + " |\n|" + " --- |" * len(part[1]))
                out.extend("| " + " | ".join(row) + " |" for row in part[2])
                out.append("")
            else:
                out.append(f"![{part[1]}]({part[1]}.svg)")
            previous = part[0]
        return "\n".join(out) + "\n"

    def html(self):
        style = ("body{font-family:sans-serif;max-width:980px;margin:2em auto;padding:0 1em;line-height:1.4}"
                 "table{border-collapse:collapse;font-size:90%}td,th{border:1px solid #ccc;padding:3px 7px;text-align:left}"
                 "th{background:#eef}svg{margin:4px;border:1px solid #ddd}.table{overflow-x:auto;margin:1em 0}")
        out = [f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8"><title>{html.escape(self.title)}</title>'
               f"<style>{style}</style></head><body><h1>{html.escape(self.title)}</h1>"]
        for part in self.parts:
            if part[0] == "heading":
                out.append(f"<h{part[1]}>{to_html(part[2])}</h{part[1]}>")
            elif part[0] == "text":
                out.append(f"<p>{to_html(part[1])}</p>")
            elif part[0] == "table":
                out.append('<div class="table"><table><tr>' + "".join(f"<th>{to_html(c)}</th>" for c in part[1]) + "</tr>")
                out.extend("<tr>" + "".join(f"<td>{to_html(c)}</td>" for c in row) + "</tr>" for row in part[2])
                out.append("</table></div>")
            else:
                out.append(self.pictures[part[1]])
        return "\n".join(out) + "</body></html>\n"

    def write(self, folder):
        for name, svg in self.pictures.items():
            (folder / f"{name}.svg").write_text(svg)
        (folder / "paper.md").write_text(self.markdown())
        (folder / "paper.html").write_text(self.html())
