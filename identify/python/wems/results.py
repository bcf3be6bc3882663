"""What a command found."""
import json
import os


class Result:
    """Prints as the table of the command line; result["parameters"] is the data that --json would write."""

    def __init__(self, answer, kind, model=None):
        self._answer = answer
        self._data = None
        self.kind = kind
        self.model = model  # fitted or extended; None where the command makes none

    def to_dict(self):
        """The data that --json writes, a new dictionary."""
        return json.loads(self._answer.json())

    def __getitem__(self, key):
        if self._data is None:
            self._data = self.to_dict()
        return self._data[key]

    def __contains__(self, key):
        if self._data is None:
            self._data = self.to_dict()
        return key in self._data

    @property
    def verdict(self):
        return self["verdict"]

    def to_pandas(self, key):
        """One of the lists of the data, such as "parameters" or "causes", as a pandas DataFrame."""
        import pandas

        return pandas.json_normalize(self[key])

    def report(self, file):
        """Writes the page with pictures that --report writes."""
        self._answer.report(os.fspath(file))

    def plot(self, ax=None):
        """Draws the main figure with Matplotlib; returns its axes."""
        from . import plots

        return plots.plot_result(self, ax)

    def __str__(self):
        return self._answer.text()

    def __repr__(self):
        return f"<wems.Result of {self.kind}>"

    def _repr_html_(self):
        import html

        return f"<pre>{html.escape(str(self))}</pre>"
