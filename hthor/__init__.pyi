from hthor.api.evaluate import evaluate as evaluate

__version__: str
