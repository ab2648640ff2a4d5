"""Layer laws beside the paper's own two: one law or family a file, each a `Layer`."""
