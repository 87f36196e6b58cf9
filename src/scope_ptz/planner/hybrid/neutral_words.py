"""Words in descriptions and questions that name no object, so that the instruction need not contain them."""

FUNCTION_WORDS = frozenset(
    """
    a an the this that these those some any all each every no none one ones it its they them their he she his her there here
    i you we me us my your our
    of in on at to from with without by for near next behind beside between above below under over around across along into onto
    inside outside through against about than as
    and or but not nor if whether so then also too only just
    is are was were be been being do does did has have had can could will would shall should may might must
    what which who whom whose where when why how many much
    please now currently
    """.split()  # noqa: SIM905 - one word list
)

ABOUT_THE_PICTURE = frozenset(
    """
    see visible seen shown appear appears look looks show shows contain contains picture image photo frame view scene camera current
    describe count number total thing object anything something kind type sort
    """.split()  # noqa: SIM905 - one word list
)
"""Words about the picture itself, which any question may contain."""
