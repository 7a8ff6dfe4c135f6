"""The one exception of this package: something the user can mend."""


class Failure(Exception):
    """What could not be done, and its remedy."""

    def __init__(self, problem: str, remedy: str):
        self.problem = problem
        super().__init__(f"{problem}\n  remedy: {remedy}")
