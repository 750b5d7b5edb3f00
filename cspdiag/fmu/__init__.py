"""FMUs of other tools, as parts of an environment: what their archives say, and how they run."""
