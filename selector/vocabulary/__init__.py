"""The words of robot and mechanism documents, one model each."""
