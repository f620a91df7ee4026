"""An entry: its record, outcomes, metrics and schema, and the rules that it must satisfy."""
