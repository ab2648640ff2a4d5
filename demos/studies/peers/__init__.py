"""The groove problem solved by other finite element packages, to measure contactdd's speed against theirs."""
