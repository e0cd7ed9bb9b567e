"""The board keeper: holds every robot's board, writes it down, answers those who come late, and proves that nothing is missing."""
