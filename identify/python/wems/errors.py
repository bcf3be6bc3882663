"""The one exception that bad input raises."""


class InputError(ValueError):
    """A file, a value or an option that cannot be used.

    file, line, key: where it is; empty or 0 where that is not known.
    problem, accepted: what is wrong, and what would be accepted.
    """

    def __init__(self, message, file="", line=0, key="", problem="", accepted=""):
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key
        self.problem = problem
        self.accepted = accepted
