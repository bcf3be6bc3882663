"""What scripts/campaign draws: test_draws.py SOURCE BUILD. Needs no program."""
import math
import os
import sys
import tempfile
import unittest

SOURCE = sys.argv.pop(1) if len(sys.argv) > 1 else "."
sys.argv[1:] = []
sys.path.insert(0, os.path.join(SOURCE, "scripts/campaign_files"))
from definition import Campaign, CampaignError  # noqa: E402
from results import find_values  # noqa: E402

MODEL = '[[connection]]\nname = "left"\n[[connection]]\nname = "right"\n'
COMMAND = [{"run": "true {seed}"}]


def make(**text):
    return Campaign({"seed": 5, "command": COMMAND, **text}, tempfile.gettempdir())


class Draws(unittest.TestCase):
    def draw(self, count=4000, **distribution):
        campaign = make(cases=count, variable=[{"name": "q", **distribution}])
        return [campaign.make_case(i)["row"]["q"] for i in range(count)]

    def check_moments(self, values, mean, deviation, kurtosis):
        """Within 4.5 standard errors, which chance exceeds in 7 of 10⁶ tests."""
        n, found = len(values), sum(values) / len(values)
        variance = sum((v - found) ** 2 for v in values) / (n - 1)
        self.assertLess(abs(found - mean), 4.5 * deviation / math.sqrt(n))
        self.assertLess(abs(variance / deviation**2 - 1), 4.5 * math.sqrt((kurtosis - 1) / n))

    def test_moments(self):
        self.check_moments(self.draw(normal=[3.0, 0.5]), 3.0, 0.5, 3)
        self.check_moments(self.draw(uniform=[-1.0, 5.0]), 2.0, 6 / math.sqrt(12), 1.8)
        logarithms = [math.log(v) for v in self.draw(log_uniform=[0.01, 100.0])]
        self.check_moments(logarithms, 0.0, math.log(1e4) / math.sqrt(12), 1.8)
        share = self.draw(values=[1, 2, 2, 2]).count(1)
        self.assertLess(abs(share - 1000), 4.5 * math.sqrt(4000 * 0.25 * 0.75))

    def test_tolerance_is_two_standard_deviations(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(f"{folder}/m.toml", "w", encoding="utf-8") as file:
                file.write(MODEL)
            campaign = Campaign({"cases": 4000, "command": COMMAND, "models": ["m.toml"],
                                 "parameter": [{"name": "*.z.stiffness", "tolerance": 0.1}]}, folder)
            changes = [campaign.make_case(i)["changes"] for i in range(4000)]
        self.assertTrue(all(c[0].startswith("left.z.stiffness*=") and c[1].startswith("right.z.stiffness*=") for c in changes))
        left, right = ([float(c[k].split("=")[1]) for c in changes] for k in (0, 1))
        self.check_moments(left, 1, 0.05, 3)
        product = sum((a - 1) * (b - 1) for a, b in zip(left, right)) / 4000
        self.assertLess(abs(product), 4.5 * 0.05**2 / math.sqrt(4000))  # drawn one by one

    def test_more_cases_and_quantities_change_no_draw(self):
        first = {"name": "a", "normal": [0.0, 1.0]}
        few = make(cases=3, variable=[first])
        many = make(cases=9, variable=[{"name": "b", "uniform": [0.0, 1.0]}, first])
        for i in range(3):
            one, other = few.make_case(i), many.make_case(i)
            self.assertEqual(one["row"]["a"], other["row"]["a"])
            self.assertEqual(one["commands"], other["commands"])

    def test_combinations_share_their_draw(self):
        campaign = make(cases=2, variable=[{"name": "a", "normal": [0.0, 1.0]}, {"name": "g", "grid": [1, 2, 3]}])
        rows = [campaign.make_case(i)["row"] for i in range(campaign.count)]
        self.assertEqual([r["g"] for r in rows], [1, 2, 3, 1, 2, 3])
        self.assertEqual(len({r["a"] for r in rows[:3]}), 1)
        self.assertNotEqual(rows[0]["a"], rows[3]["a"])

    def test_last_commands_take_kept_files(self):
        campaign = make(keep=["a.txt"], **{"finally": [{"run": "cat {all:a.txt} -n"}]})
        self.assertEqual(campaign.make_last_commands({"a.txt": ["kept/0/a.txt", "kept/1/a.txt"]}),
                         [["cat", "kept/0/a.txt", "kept/1/a.txt", "-n"]])
        with self.assertRaises(CampaignError):
            make(**{"finally": [{"run": "cat {all:a.txt}"}]})

    def test_keys_of_results(self):
        data = {"a": {"b": 1.5}, "l": [{"name": "1.z", "v": 2}, {"name": "2.z", "v": 3}]}
        for key, found in (("a.b", {"": 1.5}), ("l[name=2.z].v", {"": 3}), ("l[0].v", {"": 2}), ("l[-1].name", {"": "2.z"}),
                           ("l[name=*].v", {".1.z": 2, ".2.z": 3}), ("a.c", {}), ("l[name=3].v", {}), ("l[7].v", {})):
            self.assertEqual(find_values(data, key), found, key)

    def test_what_is_wrong_is_named(self):
        for text, said in (({"cases": 0}, "cases"), ({"colour": 1}, "colour: unknown key"),
                           ({"variable": [{"name": "a"}]}, "variable 1: 0 distributions"),
                           ({"variable": [{"name": "a", "uniform": [2, 1]}]}, "variable 1.uniform"),
                           ({"variable": [{"name": "a", "normal": [0, float("nan")]}]}, "variable 1.normal"),
                           ({"command": [{"run": "true {nobody}"}]}, "{nobody} is unknown"),
                           ({"command": []}, "no [[command]]"), ({"models": ["nowhere.toml"]}, "there is no file"),
                           ({"parameter": [{"name": "1.z.stiffness", "tolerance": 0.1}]}, "parameters without models")):
            with self.subTest(said), self.assertRaises(CampaignError) as caught:
                make(**text)
            self.assertIn(said, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
