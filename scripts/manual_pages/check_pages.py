"""Every link, anchor and picture of built pages leads somewhere."""
from html.parser import HTMLParser
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.targets, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.anchors.add(attributes.get("id"))
        for name in ("href", "src"):
            if attributes.get(name):
                self.targets.append(attributes[name])


def find_faults(folder):
    """One line for each target that is not there."""
    pages = {file.resolve(): Page(file.read_text(encoding="utf-8")) for file in sorted(folder.rglob("*.html"))}
    faults = []
    for file, page in pages.items():
        for target in page.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc:
                continue
            aimed = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not aimed.exists():
                faults.append(f"{file.relative_to(folder.resolve())}: {target} is not there")
            elif parts.fragment and aimed in pages and unquote(parts.fragment) not in pages[aimed].anchors:
                faults.append(f"{file.relative_to(folder.resolve())}: {target} has no such place")
    return faults
