"""How do two surfaces meet?"""
