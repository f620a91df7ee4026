"""Skills that built-in agents share: exploring, moving, carrying, telling the person, sharing out jobs, making way."""
