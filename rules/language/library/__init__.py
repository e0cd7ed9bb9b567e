"""The functions of the language, by what they work on; semantics are those of CLIPS 6.42."""
