"""The forward model and Simbody: one run of tests/peers/peer_run each."""
import json
import os
import subprocess
import tempfile

import numpy as np


class Programs:
    """Runs peer_run on a model under a sweep."""

    def __init__(self, program, model_file, plan):
        self.program = program
        self.plan = {**plan, "model": model_file}

    def run(self, name, repetitions=1, **options):
        """Displacements at the samples, evaluations, CPU time in s (the mean of the repetitions)."""
        with tempfile.TemporaryDirectory() as folder:
            plan, output = os.path.join(folder, "plan.json"), os.path.join(folder, "q")
            with open(plan, "w") as file:
                json.dump({**self.plan, "program": name, "output": output, "repetitions": repetitions, **options}, file)
            done = subprocess.run([self.program, plan], check=True, stdout=subprocess.PIPE, text=True)
            result = json.loads(done.stdout)
            q = np.fromfile(output).reshape(round(self.plan["duration"] * self.plan["sample_rate"]) + 1, -1)
        return q, result["evaluations"], float(np.mean(result["cpu_time"]))

    def forward(self, steps_per_sample):
        return self.run("forward", repetitions=2, steps_per_sample=steps_per_sample)

    def simbody(self, accuracy, longest_step):
        return self.run("simbody", accuracy=accuracy, longest_step=longest_step)
