"""What a user can mend, and what a user should know."""


class Failure(Exception):
    """What could not be done, and its remedy."""

    def __init__(self, problem: str, remedy: str):
        self.problem = problem
        self.remedy = remedy
        super().__init__(f"{problem}\n  remedy: {remedy}")

    def __reduce__(self) -> tuple[type["Failure"], tuple[str, str]]:
        return Failure, (self.problem, self.remedy)


class TyndallWarning(UserWarning):
    """What the program warns of."""
