"""CSPm, the language of the refinement checker FDR."""
