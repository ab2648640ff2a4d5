"""What does a body touch that needs no mesh? Rigid bodies, elastic grounds by influence functions, mirror planes."""
