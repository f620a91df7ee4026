"""The metrics: what each is (`definitions`, one file a family), all of them (`registry`), and a trial's values of them.

Begin with `metric.Metric`; a new metric is a record in a file of `definitions`, and nothing else.
"""
