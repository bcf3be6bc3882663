"""Models that nobody means: each draw changes numbers of a good one, takes parts away or damages its bytes."""
import re

from odd_recordings import damage

NUMBER = re.compile(r"(?<![\w.])-?\d+\.?\d*(?:e[+-]?\d+)?(?![\w.])")
ODD = ["0.0", "-1.0", "1e300", "-1e300", "1e-300", "1e15", "1e9", "1e6", "1e-9", "1e-15", "nan", "inf", "1", "true", "[]"]


def replace_key(text, key, value):
    return re.sub(rf"(\b{key}\s*=\s*)[^,}}\n#]+", lambda match: match.group(1) + value, text)


def number_anywhere(text, random):
    places = list(NUMBER.finditer(re.sub(r"#.*", lambda match: " " * len(match.group()), text)))
    for place in sorted(random.sample(places, random.choice([1, 1, 2, 5])), key=lambda p: -p.start()):
        text = text[:place.start()] + random.choice(ODD) + text[place.end():]
    return text


def one_key(text, random):
    key = random.choice(["stiffness", "damping", "clearance", "mass", "frequency", "damping_ratio"])
    return replace_key(text, key, random.choice(ODD[:10]))


def scaled_key(text, random):
    key = random.choice(["stiffness", "damping", "clearance", "mass"])
    factor = random.choice([1e-9, 1e-4, 1e-2, 1e2, 1e4, 1e9])
    return re.sub(rf"(\b{key}\s*=\s*)([\d.e+-]+)",
                  lambda match: match.group(1) + repr(float(match.group(2)) * factor), text)


def all_stiffness_zero(text, random):
    return replace_key(text, "stiffness", "0.0")


def no_parts(text, random):
    part = random.choice([r"^stops = .*?\]\s*$", r"^damping = .*$", r"^\[bracket\][^\[]*", r"^stiffness = .*$", r"^mass = .*$",
                          r"^inertia = .*$", r"^\[connection\..\][^\[]*"])
    return re.sub(part, "", text, flags=re.MULTILINE | re.DOTALL if "stops" in part else re.MULTILINE)


def same_place(text, random):
    place = random.choice(["[0.0, 0.0, 0.0]", "[1e6, 0.0, 0.0]", "[0.1, 0.0, 0.0]"])
    return re.sub(r"position = \[.*?\]", "position = " + place, text)


def fewer_connections(text, random):
    head, *connections = text.split("[[connection]]")
    return "[[connection]]".join([head, *random.sample(connections, random.randrange(len(connections)))])


def many_connections(text, random):
    head, *connections = text.split("[[connection]]")
    count = random.choice([12, 60])
    copies = [re.sub(r'name = ".*?"', f'name = "c{i}"', random.choice(connections)) for i in range(count)]
    return "[[connection]]".join([head, *copies])


def more_tables(text, random):
    value = random.choice(["0.0", "-1.0", "1e9", "1e-12", "1e300"])
    return text + "\n" + random.choice([
        f"[load]\ngain = {value}\n",
        f'[[sensor]]\nchannel = "mobile.1.az"\ngain = {value}\n',
        f'[[sensor]]\nchannel = "mobile"\ndelay = {value}\n',
        f'[[sensor]]\nchannel = "fixed.2"\nrotation = [{value}, 0.0, {value}]\n',
        f'[[marker]]\nname = "m"\npart = "mobile"\nposition = [{value}, 0.0, 0.0]\nchannels = {{ x = "mobile.1.x" }}\n',
        f"[[bracket.mode]]\nindex = 1\nfrequency = {value}\ndamping_ratio = {value}\n",
        ".".join(["a"] * random.choice([50, 50000])) + " = 1\n",
        "a = " + "[" * random.choice([50, 50000]) + "\n",
        "[" + ".".join(["x"] * 30000) + "]\n",
    ])


def odd_law(text, random):
    value = random.choice(["0.0", "1e9", "1e-12", "-1.0", "1e300", "0.5"])
    law = random.choice([f"offset = {value}", f"cubic = {value}", f"loss_factor = {value}", f"drift = {value}",
                         f"relaxation = {{ stiffness_ratio = {value}, time_constant = 1e-9 }}",
                         f"friction = {{ force = {value}, transition_velocity = 1e-9 }}",
                         f"hysteresis = {{ force = {value}, yield_displacement = 1e-9 }}"])
    return re.sub(r"^(\[connection\.z\])$", lambda match: match.group(1) + "\n" + law, text, flags=re.MULTILINE)


def odd_body(text, random):
    value = random.choice(["1e6", "-1e6", "1e300", "1e-9", "5.0"])
    line = random.choice([f"center_of_gravity = [0.0, 0.0, {value}]", f"inertia = [{value}, {value}, {value}]",
                          f"spin = [{value}, 0.0, 0.0]", "inertia = [1.0, 1.0, 1.0, 5.0, 5.0, 5.0]"])
    key = line.split()[0]
    if re.search(rf"^{key} = ", text, flags=re.MULTILINE):
        return re.sub(rf"^{key} = .*$", line, text, flags=re.MULTILINE)
    return text.replace("[body]", "[body]\n" + line)


def gravity(text, random):
    line = f"gravity = [0.0, {random.choice(['0.0', '9.81', '1e5'])}, {random.choice(['-9.81', '1e9', '-1e3'])}]"
    return re.sub(r"^gravity = .*$", "", line + "\n" + text if "gravity" not in text else text, flags=re.MULTILINE) \
        if "gravity" in text else line + "\n" + text


DRAWN = [number_anywhere, number_anywhere, number_anywhere, one_key, scaled_key, all_stiffness_zero, no_parts, same_place,
         fewer_connections, many_connections, more_tables, more_tables, odd_law, odd_law, odd_body, gravity]


def draw_model(good, modes, random):
    """Bytes of an odd model and of its modes file, and what was done."""
    if random.random() < 0.12:
        return damage(good.encode(), random), modes.encode(), "damage"
    if random.random() < 0.06:
        return good.encode(), damage(modes.encode(), random), "damaged modes"
    oddity = random.choice(DRAWN)
    return oddity(good, random).encode(), modes.encode(), oddity.__name__
