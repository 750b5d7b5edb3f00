"""Names, types and units: from syntax trees to a typed program."""
