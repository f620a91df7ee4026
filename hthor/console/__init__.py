"""Parts that all commands share: output, tables, help texts, completion and exit codes."""
