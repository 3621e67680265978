"""What builds without FLINT say where they are asked for proofs."""

MISSING = "this build has no FLINT"
