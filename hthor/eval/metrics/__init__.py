"""The metrics: what each is (`definitions`, one file per family), the list (`registry`), and their values in a trial.

Begin with `metric.Metric`; a new metric is a record in a file of `definitions`, and nothing else.
"""
