"""All bodies as one."""
