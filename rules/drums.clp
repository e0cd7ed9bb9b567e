; What is looked for in the warehouse: eight drums (their colour and size stand in the mission file, with the source that looks).

(deffacts drums (looking-for drum 8))
