"""What a plot saves: SVG with a path for each series shown, PNG of the same shape, CSV with the numbers of the page."""
import csv
import math
import struct
import time
import xml.etree.ElementTree as ElementTree

SVG = "{http://www.w3.org/2000/svg}"


def wait_for_file(folder, ending, seconds=20):
    """The file that a download leaves, or None."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = [file for file in folder.glob("*" + ending) if file.stat().st_size > 0]
        if found:
            return found[0]
        time.sleep(0.05)
    return None


def check_numbers(file, series, name, checks):
    """Each point of each series stands in the table."""
    with open(file, newline="") as table:
        rows = list(csv.reader(table))
    checks.check(len(rows[0]) == 1 + len(series), f"{name}: a column for each series: {rows[0]}")
    for column, (title, (x, y)) in enumerate(series.items(), 1):
        checks.check(len(series) == 1 or rows[0][column].startswith(title + ", "), f"{name}: column of {title}")
        saved = [(float(row[0]), float(row[column])) for row in rows[1:] if row[column]]
        expected = [pair for pair in zip(x, y) if math.isfinite(pair[1])]
        checks.check(sorted(saved) == sorted(expected), f"{name}: CSV holds the {len(expected)} points of {title}")


def check_saving(browser, name, out, checks, plots):
    folder = out / "saved"
    folder.mkdir(exist_ok=True)
    for old in folder.iterdir():
        old.unlink()
    browser.execute_cdp_cmd("Browser.setDownloadBehavior", {"behavior": "allow", "downloadPath": str(folder.resolve())})
    figure = next(figure for figure in browser.find_elements("css selector", "figure")
                  if figure.find_elements("css selector", ".plot"))
    title = figure.find_element("css selector", "figcaption").text
    browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", figure)
    saved = {}
    for button in figure.find_elements("css selector", ".save button"):
        button.click()
        saved[button.text] = wait_for_file(folder, "." + button.text.lower())
        checks.check(saved[button.text], f"{name}: «{title}» is saved as {button.text}")
    checks.check(sorted(saved) == ["CSV", "PNG", "SVG"], f"{name}: three kinds of file: {sorted(saved)}")
    if not all(saved.values()):
        return
    root = ElementTree.parse(saved["SVG"]).getroot()
    paths = [path for path in root.iter(SVG + "path") if path.get("class") == "series"]
    words = [text.text for text in root.iter(SVG + "text")]
    checks.check(len(paths) == len(plots[title]), f"{name}: a path in the SVG for each series")
    checks.check(all(len(path.get("d")) > 20 and "NaN" not in path.get("d") for path in paths), f"{name}: paths have points")
    names = set(plots[title]) if len(plots[title]) > 1 else set()
    checks.check({title, *names} <= set(words), f"{name}: title and names of the series in the SVG: {words[-6:]}")
    header = saved["PNG"].read_bytes()[:24]
    width, height = struct.unpack(">II", header[16:])
    checks.check(header[:4] == b"\x89PNG" and (width, height) == tuple(2 * int(root.get(k)) for k in ("width", "height")),
                 f"{name}: PNG of {width} x {height}")
    check_numbers(saved["CSV"], plots[title], name, checks)
