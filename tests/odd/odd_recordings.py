"""Recordings that a laboratory hands over by mistake: each function draws one oddity into a good recording."""

import math
import re


class Recording:
    """A CSV as columns of texts."""

    def __init__(self, text):
        lines = [line for line in text.splitlines() if not line.startswith("#")]
        self.header = lines[0].split(",")
        rows = [line.split(",") for line in lines[1:]]
        self.columns = [[row[c] for row in rows] for c in range(len(self.header))]

    def numbers(self, c):
        """NaN where an oddity before left no number."""
        return [float(text) if re.fullmatch(r"-?[\d.]+(e[+-]?\d+)?|-?inf|nan", text) else math.nan
                for text in self.columns[c]]

    def set(self, c, values):
        self.columns[c] = [repr(float(value)) for value in values]

    def scale(self, wanted, factor):
        for c, name in enumerate(self.header):
            if wanted in name:
                self.set(c, [factor * value for value in self.numbers(c)])

    def keep(self, wanted):
        chosen = [c for c, name in enumerate(self.header) if c == 0 or wanted(name)]
        self.header = [self.header[c] for c in chosen]
        self.columns = [self.columns[c] for c in chosen]

    def cut(self, rows):
        self.columns = [column[:rows] for column in self.columns]

    def rename(self, old, new):
        self.header = [name.replace(old, new) for name in self.header]

    def text(self):
        rows = [",".join(row) for row in zip(*self.columns)]
        return "\n".join([",".join(self.header), *rows]) + "\n"


def few_rows(r, random):
    r.cut(random.choice([0, 1, 2, 3, 4, 5, 8, 13, 21, 60]))


def wrong_unit_of_time(r, random):
    r.set(0, [random.choice([1e3, 1e-3, 60, 1e6, 1e-6]) * t for t in r.numbers(0)])


def odd_time(r, random):
    t = r.numbers(0)
    at = random.randrange(1, len(t) - 1)
    kind = random.randrange(7)
    if kind == 0:
        t = t[::-1]
    elif kind == 1:
        t = [x + 1e9 for x in t]
    elif kind == 2:
        t = t[:at] + [x + random.choice([0.5, 100, 1e8]) for x in t[at:]]
    elif kind == 3:
        t = [0.0] * len(t)
    elif kind == 4:
        t[at] = t[at - 1]
    elif kind == 5:
        t = [x + random.uniform(-1, 1) * 5e-3 for x in t]
    else:
        t = [abs(x)**random.choice([2, 0.5]) for x in t]
    r.set(0, t)


def reversed_values(r, random):
    for c in range(1, len(r.header)):
        r.columns[c].reverse()


def odd_cells(r, random):
    value = random.choice(["1e308", "-1e308", "1e-308", "nan", "inf", "", "1e400", "0x10", "-", "1,5", "5e", "1e30"])
    for _ in range(random.choice([1, 1, 1, 5, 300])):
        column = random.choice(r.columns)
        column[random.randrange(len(column))] = value


def odd_channel(r, random):
    c = random.randrange(1, len(r.header))
    values = r.numbers(c)
    kind = random.randrange(7)
    if kind == 0:
        values = [0.0] * len(values)
    elif kind == 1:
        values = [random.choice([1.0, -1e6, 1e-300])] * len(values)
    elif kind == 2:
        largest = 0.3 * max(abs(x) for x in values)
        values = [max(-largest, min(largest, x)) for x in values]
    elif kind == 3:
        values = [random.gauss(0, 1e3) for _ in values]
    elif kind == 4:
        factor = random.choice([-1, 1e3, 1e-3, 9.80665, 1e12, 1e150, 1e-150, 1e300])
        values = [factor * x for x in values]
    elif kind == 5:
        at = random.randrange(len(values))
        values = values[at:] + values[:at]
    else:
        values = r.numbers(random.randrange(len(r.header)))
    r.set(c, values)


def odd_side(r, random):
    side = random.choice(["mobile.", "fixed.", "load.", "mobile.1", "fixed.3", ".az", ".z ", "["])
    r.scale(side, random.choice([-1, 0, 1e3, 1e-3, 1 / 9.80665, 9.80665, 1e9, 1e-12, 1e200]))
    if side == "[":  # all of them, the time too
        r.set(0, [1e-3 * k for k in range(len(r.columns[0]))])


def all_still(r, random):
    for c in range(1, len(r.header)):
        r.set(c, [random.choice([0.0, random.gauss(0, 1e-9)]) for _ in r.columns[c]])


def few_channels(r, random):
    part = random.choice(["mobile", "fixed", "load", ".z ", ".az", "1.", "[m]", "m/s^2", "nothing", ".x ", "mobile.1.z"])
    r.keep(lambda name: part in name)


def some_channels(r, random):
    share = random.random()
    r.keep(lambda name: random.random() < share)


def odd_names(r, random):
    a, b = random.sample(["1.", "2.", "3.", "4."], 2)
    kind = random.randrange(5)
    if kind == 0:
        r.header = [n.replace(a, "@").replace(b, a).replace("@", b) if "mobile" in n else n for n in r.header]
    elif kind == 1:
        r.rename(a, "9.")
    elif kind == 2:
        r.rename(a, b)
    elif kind == 3:
        r.rename("[m]", random.choice(["[furlong]", "[s]", "[mm]", "[in]", "", "[]"]))
    else:
        r.rename("mobile", random.choice(["fixed", "base", "relative", "", "MOBILE"]))


def component_test(r, random):
    r.keep(lambda name: "mobile.1.z" in name or "load.fz" in name)
    r.rename("mobile.1.z", "relative.1.z")
    r.rename("load.fz", "force.1.z")
    if random.random() < 0.5:
        random.choice([few_rows, odd_cells, odd_channel, reversed_values])(r, random)


def two_oddities(r, random):
    for _ in range(2):
        random.choice([odd_time, odd_cells, odd_channel, odd_side])(r, random)


DRAWN = [few_rows, wrong_unit_of_time, odd_time, reversed_values, odd_cells, odd_channel, odd_channel, odd_side, odd_side,
         all_still, few_channels, some_channels, odd_names, component_test, two_oddities]


def damage(content, random):
    """Bytes of any file: cut, flipped, put in, repeated."""
    kind = random.randrange(5)
    at = random.randrange(len(content))
    if kind == 0:
        return content[:at]
    if kind == 1:
        changed = bytearray(content)
        for _ in range(random.choice([1, 3, 100])):
            changed[random.randrange(len(changed))] = random.randrange(256)
        return bytes(changed)
    if kind == 2:
        return content[:at] + bytes(random.randrange(256) for _ in range(random.choice([1, 10, 1000]))) + content[at:]
    if kind == 3:
        return content[:at] + content[at // 2:]
    return content.decode("latin-1").encode(random.choice(["utf-16", "utf-16-le", "utf-8-sig"]))


def draw_recording(good, random):
    """Bytes of an odd CSV, and what was done to it."""
    if random.random() < 0.2:
        return damage(good.encode(), random), "damage"
    recording = Recording(good)
    oddity = random.choice(DRAWN)
    oddity(recording, random)
    return recording.text().encode(), oddity.__name__
