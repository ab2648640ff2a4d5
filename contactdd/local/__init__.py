"""How is one body solved?"""
