"""Many cases of one deck on many processes or machines, merged into one folder."""
