"""What can be told of rule files before they run: names that do not exist, rules that cannot fire, order that is left to chance."""
