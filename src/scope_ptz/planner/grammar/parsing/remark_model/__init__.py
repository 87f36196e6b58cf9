"""Tell remarks from requests with a linear model that is trained on the instructions in the tests."""
