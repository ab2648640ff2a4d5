"""How is the system solved?"""
