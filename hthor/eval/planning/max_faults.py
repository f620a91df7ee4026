"""The option `--max-faults` of `hthor eval`: a number or a share of trials."""

import math
from collections.abc import Callable

from hthor.errors import HthorError


def parse_max_faults(text: str) -> Callable[[int], float]:
    """How many of a number of trials may have a fault, for a text such as "3" or "5%".

    Raises:
        HthorError: when the text is neither a number nor a share of trials.
    """
    number, percent = text.strip().removesuffix("%"), text.strip().endswith("%")
    try:
        value = float(number) if percent else int(number)
    except ValueError:
        value = -1.0
    if not 0.0 <= value < math.inf or (percent and value > 100.0):
        raise HthorError(
            f"--max-faults '{text}' is neither a number of trials, such as 3, nor a share of them, such as 5%."
        )
    return lambda trials: value / 100.0 * trials if percent else value
