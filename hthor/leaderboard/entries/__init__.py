"""An entry: its record, outcomes, metrics, schema and laws."""
