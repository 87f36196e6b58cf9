"""Patterns for shorthand, dialect and signatures in the text of an instruction, with standard English or nothing in their place."""

from __future__ import annotations

_NAMES = r"(?-i:[A-Z][\w.]*(?:,? [A-Z][\w.]*)*)"
_CLOSINGS = (
    r"(?:(?:kind|best|warm|with kind) regards|regards|many thanks|with thanks|thanks|best wishes|cheers|yours(?: \w+)?|thank you)"
)

SHORTHAND = (
    (rf"(?:(?<=[.?!])|,)\s*{_CLOSINGS},? {_NAMES}\s*[.!]?$", ""),
    (r"^dear (?:all|team|colleagues|sirs?),? ", ""),
    (r"\s*[\U0001F300-\U0001FAFF\u2600-\u27BF]+", ""),
    (r"\bw/ ?(?=\w)", "with "),
    (r"\b4 (me|us)\b", r"for \1"),
    (r"\b2 (?=the\b)", "to "),
    (r"\br (there|they|you|we)\b", r"are \1"),
    (r"\b(how many (?:\w+ ){1,3})r there\b", r"\1are there"),
    (r",? \brn\b(?= this\b)", ","),
    (r",? \brn\b", ""),
    (r"\bu r\b", "you are"),
    (r"\b(behind|below|under|around|past) (?:u|ya|yous)\b", r"\1 you"),
    (r"\bwanna\b", "want to"),
    (r"\boughta\b", "ought to"),
    (r"\bgies\b", "give me"),
    (r"\b(list|photo|picture|pic|shot|number|count|view) o (?=the|that|all)", r"\1 of "),
    (r"\balot\b", "a lot"),
    (r"\ba lil (?:bit )?", "a little bit "),
    (r"\b(?:ah|i) cannae\b", "i can't"),
    (r"\bah (?=need|want|think|can)", "i "),
    (r",? by (?:here|there)(?=\W*$)", ""),
    (r", (?:boy|my lover|butt|bach|bab|cock|hen|babes|mun|guv|my lovely|like)(?=\s*[,.!?]|$)", ""),
    (r" mun(?=,|\.|$)", ""),
    (r"\b(don['’]t \w+(?: the \w+)?) none\b", r"\1"),
    (r", how copy\?*$", ""),
    (r", over(?: and out)?\s*[.!]*$", ""),
    (r"^(?:ugh+|omg|argh+|ooh|whoa|yikes),? ", ""),
    (r"\bI (reckon|guess|suppose|believe)(?=\s*[.!?]*$)", ""),
    (r"\b(?:my|me) eyes (?:are not|aren['’]t|ain['’]t|isn['’]t) what they (?:used to be|were)\b", "my eyes are bad"),
    (r"(?<=\w) i (?=(?:left|lost|dropped) (?:it|them)\b)", ", i "),
    (r"(?<=\w) (?=(?:ur|you['’]re) too (?:close|far|high|low)\b)", ", "),
    (r"(?<=\w) (?=i wan(?:na|t to) see what(?:['’]?s| is) behind)", ", "),
    (r"(?<=\w) (?=its got my\b|this \w+ is unreal\b|i(?:['’]m|m) starving\b)", ", "),
    (r"\b(could|can|would|did|do|does|has|have|is|are|was|were)nt\b", r"\1n't"),
    (r"(^|[.!] )right there[,!] (?=\w)", r"\1"),
    (r"^(?:point taken|fair enough|fair point|understood|will do|no worries|i['’]ve lost (?:track|count))[.,!] ", ""),
    (r"^(?:hang|hold) on(?: a (?:second|sec|minute|moment|tick))?(?:\.\.\.|…|,|\.) *(?:(?:ok|okay|right), )?", ""),
    (r"^home in on ", "zoom in on "),
    (
        r"^(?:i['’]ll|i will) (?:do|pan|tilt|zoom|handle|move|swing|turn)\b[^,.;]*[,.;] (?=(?:just |please )?(?:count"
        r"|pan|tilt|zoom|take|go|tell)\b)",
        "",
    ),
    (r"^leave the (?:pan|tilt|zoom)(?:ning|ting|ing)? to me(?: and|,) ", ""),
    (r"^forget (?:about )?(?:the )?(?:panning|tilting|zooming|zoom|pan|tilt), ", ""),
    (r"[.!,?]? *(?<=\W)(?:thank you|thanks)(?: (?:so|very) much| a lot| kindly| in advance)[.!]*$", "."),
    (r"^right,? so,? ", ""),
    (r"\babit\b", "a bit"),
    (r"\b(people|they|cars|vans|trucks|lorries|kids|bags|boxes) r\b", r"\1 are"),
    (r"\b(he|she)s (?=\w)", r"\1's "),
    (r"\bfor like (?=\w+ (?:sec|min))", "for "),
    (r",? (?:and )?once it(?:['’]s| is) there,? (?:please )?(?=\w)", ", then "),
    (r", (?:pardon(?: me)?|excuse me|my mistake|whoops|oops), ", ", no, "),
    (r"(?<=\w) (?=can(?:['’]?t|not) (?:see|read|make out) )", ", "),
    (r"[.,] (?:priority|urgent|urgently|asap|top priority)\W*$", ""),
    (r"^(?:hiya|hi|hello|hey),? (?:it['’]?s )?(?:only )?me again[!.,] ", ""),
    (r",? hun\b", ""),
    (r"\bobtain\b", "get"),
    (r"\binform me\b", "tell me"),
    (r"^(?:good (?:morning|afternoon|evening)|hello|hiya|hi)[.!] ", ""),
)
"""Patterns with the words that replace them."""
