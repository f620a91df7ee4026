"""The population by the literature alone: drawn from the priors."""

from hthor import seeds
from hthor.humans.population import parameter_registry
from hthor.humans.population.population import Population, Validity

DRAWS = 512
"""[count] Draws of the population from the priors. Our choice: quantiles are exact to 1/1024 of the probability."""
_ROOT = seeds.derive(0, "literature")
_DIGITS = 12
"""[digits] Significant digits of every value. Our choice: further digits may differ between libraries."""
_NOTES = (
    "Every parameter is drawn from its prior: these people agree with the literature, and were fitted to no data.",
)


def make_prior_population() -> Population:
    """One draw from each of `DRAWS` strata of every prior, with the strata of different parameters mixed."""
    orders = [seeds.shuffled(DRAWS, _ROOT, name) for name in parameter_registry.free_parameter_names()]
    points = [[(order[row] + 0.5) / DRAWS for order in orders] for row in range(DRAWS)]
    draws = [
        [float(f"{value:.{_DIGITS}g}") for value in row] for row in parameter_registry.from_quantiles(points).tolist()
    ]
    return Population.make(
        "literature",
        draws,
        purpose="people drawn from the priors, fitted to nothing",
        seed=0,
        command="hthor.humans.population.prior_population.make_prior_population()",
        notes=_NOTES,
        validity=Validity(),
    )
