"""Patterns for greetings, courtesy, signatures and labels, which are left out, and for polite requests."""

from __future__ import annotations

from scope_ptz.english.grammar.numbers import NUMBER_WORDS

_NAMES = r"(?-i:[A-Z][\w.]*(?:,? [A-Z][\w.]*)*)"
_CLOSINGS = (
    r"(?:(?:kind|best|warm|with kind) regards|regards|many thanks|with thanks|thanks|best wishes|cheers|yours(?: \w+)?|thank you)"
)

_NUMBER = "|".join(word for word in NUMBER_WORDS if word.isalpha())
_BEFORE_ADDRESS = (
    r"(?<!the )(?<!that )\b(a lot|a bit|a little|all the way|in|out|left|right|up|down|around|degrees?|deg|home|please|again"
    rf"|\d+x|seconds?|minutes?|times|percent|(?:left|right|up|down|by) (?:\d+|{_NUMBER}))"
)
"""Words at the end of a command, after which a form of address needs no comma: "down a lot, dude"."""

_TIME = r"(?:\d+(?:\.\d+)?|an?|half an?|[a-z]+(?:-[a-z]+)?) ?(?:s|secs?|seconds?|mins?|minutes?)(?: and a half)?"

_TESTS = r"test|trial|check|test step|step|test case|case|test run|run|item|task"
_DUTIES = (
    r"(?:night|day|evening|morning|late|early|hourly|routine|security|shift|last|first|next|final|fire|safety) "
    r"(?:rounds?|checks?|patrols?|watch|tour|report|count|roll ?call|drill|inspection)"
)
COURTESIES = (
    (rf"^(?:{_TESTS})(?: (?:number|no\.?|step))? \d+[a-z]?\s*[:.,;-]+\s+(?=\w)", ""),
    (
        r"[,.;] (?:this is |it's |that's )?(?:the )?(?:pan|tilt|zoom|pan[- ]and[- ]tilt|tracking|focus|preset|camera"
        r"|speed|repeatability) "
        rf"(?:test|check|trial|run)(?: (?:run|step))?(?: (?:number |no\.? ?)?(?:\d+|{_NUMBER}))?\W*$",
        "",
    ),
    (rf"^{_DUTIES}\s*[:;-]\s+(?=\w)", ""),
    (rf",\s*{_DUTIES}\W*$", ""),
    (r"(?<!wait)(?<!waiting)(?<!left)(?<!ready) for (?:me|us) (?=(?:at|on|in|by|outside) (?:the|each|every|both)\b)", " "),
    (rf"^(?:auto[- ]?)?tracking(?: test| check)?[,:] ({_TIME})[,:] (?=the |an? |that |this )([^.;]+?)\W*$", r"track \2 for \1"),
    (
        rf"^(?:the )?duration(?: is|:)? ({_TIME})[.,;:] (?:please )?((?:follow|track|trail|tail|shadow|keep|stay)\b[^.;]*?)\W*$",
        r"\2 for \1",
    ),
    (
        r",? if you (?:can|could),? ((?:please|pls|thank you|thanks|cheers|ta|much appreciated)(?: very much| so much| a lot)?)"
        r"(?=\W*$)",
        r", \1",
    ),
    (r"^(?-i:[A-Z])\w+ here, (?=i |can |could |please|we )", ""),
    (r"^(?:just |only )?(?:trying|testing|checking|practising)(?: out)? (?:the |this |your )?[\w ]{1,30}: ", ""),
    (r"[,.] (?:that|this) should (?:line it up|do it|get it|be enough|sort it)\W*$", ""),
    (r"[,.] (?:that['’]?s|thats|that is) all it needs\W*$", ""),
    (r"[,.] [a-z]{3,15} behind (?:u|you|us|me)\W*$", ""),
    (r"\b(then|and) again (?=take |pan |tilt |zoom |turn )", r"\1 "),
    (
        r"\b(i|we)(?: would|['’]d) (?:also|really|quite|rather|still|actually|ideally|very much|so|dearly) "
        r"(?=(?:like|love)\b(?! (?:left|right)))",
        r"\1 would ",
    ),
    (
        r"^(an?|the) ([^,.;?]*\b(?:degrees?|percent|turn|times)\b[^,.;?]*) (?:would|should|will) be "
        r"(?:sufficient|adequate|enough|ideal|fine|perfect|plenty)\W*$",
        r"\1 \2",
    ),
    (
        r"\bi (?:should|would|['’]d) be (?:most |very |ever so )?(?:grateful|obliged|glad|pleased) if the camera "
        r"(?:could|would|might) be (?=turned|panned|tilted|pointed|moved|swung|rotated)",
        "the camera should be ",
    ),
    (r",? one (?:straight |right |directly )?after (?:the other|another)\W*$", ""),
    (r",? no (?:rush|hurry|panic|pressure) at all\b", ""),
    (r", (?:would|will|could|can) you(?=[,.!?]|$)", ""),
    (rf"(?:(?<=[.?!])|,)\s*{_CLOSINGS},? {_NAMES}\s*[.!]?$", ""),
    (r"\s*[\U0001F300-\U0001FAFF\u2600-\u27BF]+", ""),
    (r",? by (?:here|there)(?=\W*$|, \w+\W*$)", ""),
    (r", (?:boy|my lover|butt|bach|bab|cock|hen|babes|mun|guv|my lovely|like)(?=\s*[,.!?]|$)", ""),
    (r" mun(?=,|\.|$)", ""),
    (r", over(?: and out)?\s*[.!]*$", ""),
    (r"^(?:ugh+|omg|argh+|ooh|whoa|yikes),? ", ""),
    (r"\b(?:my|me) eyes (?:are not|aren['’]t|ain['’]t|isn['’]t) what they (?:used to be|were)\b", "my eyes are bad"),
    (r"(?<=\w) i (?=(?:left|lost|dropped) (?:it|them)\b)", ", i "),
    (r"(^|[.!] )right there[,!] (?=\w)", r"\1"),
    (r"^(?:point taken|fair enough|fair point|understood|will do|no worries|i['’]ve lost (?:track|count))[.,!] ", ""),
    (r"^(?:hang|hold) on(?: a (?:second|sec|minute|moment|tick))?(?:\.\.\.|…|,|\.) *(?:(?:ok|okay|right), )?", ""),
    (r"^right,? so,? ", ""),
    (r", (?:pardon(?: me)?|excuse me|my mistake|whoops|oops), ", ", no, "),
    (r"[.,] (?:priority|urgent|urgently|asap|top priority)\W*$", ""),
    (r"^(?:hiya|hi|hello|hey),? (?:it['’]?s )?(?:only )?me again[!.,] ", ""),
    (r",? hun\b", ""),
    (r"^right (?=(?:get it|get me|take me|can you|could you|let['’]s|nip|pop|show me)\b)", ""),
    (r"^(?:zoom|picture|view|shot) is too (?:tight|close|wide|far), ", ""),
    (r", (?:the )?\w+(?:['’]?s)? due (?:any \w+|soon|(?:in|at) [\w ]+)\W*$", ""),
    (r", over(?: and out)?\s*\?\s*$", "?"),
    (r",? i do apologi[sz]e,? ", ", sorry, "),
    (r"(?:^|(?<=[.;,] )|(?<=\n))step (?:\d|one|two|three|four|five|six) ?[:.,–-] *", ""),
    (r"\bmind (?:terribly|awfully|very much|ever so much) ", "mind "),
    (r"\b(could|can|might|would) (?:possibly|perhaps|kindly) ", r"\1 "),
    (r",? \b(?:dude|bro|bruv|buddy)\b(?= (?:we|it|its|you|i|the|there|they)\b)", ","),
    (r"^(?:tc|test|case|step|job|req|task)[- ]?[\d.]+ ?[:.] ", ""),
    (r",? (?:oh,? )?i beg your pardon,? ", ", sorry, "),
    (r"\b(?:with|wi) (?:ye|you)\W*$", ""),
    (r"\b(?:very|most) kindly (?=tell|show|go|take|turn|pan|tilt|zoom|count|find)", ""),
    (r",? if i (?:may|might)(?: enquire| inquire| ask| say so)?,", ""),
    (r",? if you (?:please|would|will)(?=[,.]|\W*$)", ""),
    (r",? (?:and )?(?:thank you|thanks) for (?:your|the|all)\b[^,.;?!]*\W*$", ""),
    (r",? with (?:my )?(?:sincere|many|warm|best|kind) thanks\b[^,.;?!]*\W*$", ""),
    (r",? for (?:old times['’]?|goodness|pity['’]?s?|heaven['’]?s?) sake\b", ""),
    (r",? if it(?: is|['’]s) not (?:an? |too much )?(?:inconvenience|impertinence|imposition|trouble|bother)\b[^,.;?]*", ""),
    (r",? if (?:she|he|they|you) would not (?:consider|think|mind|object)\b[^,.;?]*", ""),
    (r",? if (?:that|it|this) can be (?:managed|done|arranged)\b[^,.;?]*", ""),
    (r"\b(?:would|could|will|can|might) you (?:please )?be so (?:very |most )?(?:kind|good) (?:as to|and) ", "please "),
    (r"\b(?:could|may|might|can) i (?:prevail upon|trouble|persuade|impose upon|ask|beg) you to ", "please "),
    (r"\b(?:could|may|might|can) i trouble you for (?=an? |the |one )", "please take "),
    (r"\bi wonder (?:whether|if) (?:i|we) (?:might|could|may) (?:ask|trouble) you to ", "please "),
    (r"\bi (?:should|would|['’]d) (?:very much |dearly |really )?like you to ", "please "),
    (r",? (?:i think )?(?:that['’]?s|thats|that is) about (?:where|right|it)\b[^,.;?]*\W*$", ""),
    (r",? if you(?:['’]d| would| could) be so (?:good|kind)(?: as to)?\b", ""),
    (r"(?<=\w) (?=it['’]s too \w+)", ", "),
    (
        rf"{_BEFORE_ADDRESS} (?:my )?(?:man|partner|boss|buddy|pal|mate|matey|dude|bro|bruv|fam|chief|skipper|amigo|geezer|babe)\b"
        r"(?=,|\W*$)",
        r"\1",
    ),
    (
        r"(?<!the )\b(a lot|a bit|all the way|left|right|down|degrees|home|please|\d+x|seconds|(?:up|by|left|right|down) \d+)"
        r" (?:lads|chaps|guys|folks|fellas)(?=,|\W*$)",
        r"\1",
    ),
    (r"^(?:oh,? )?do (?=look at|zoom|take|go|count|follow|show|find|tell)", ""),
    (r",? or what\?$", "?"),
    (r",? on reflection,? ", ", "),
    (r"\bi should very much like (?=an? |to )", "i should like "),
    (r"^(?:the )?(?:field of view|framing) is too (?:tight|close|wide|far)[,.] ", ""),
    (r"^any idea (?=how many|what|where|who)", ""),
    (r"\b(?:could|can|shall) we (?=zoom|pan|tilt|turn|count)", "please "),
    (
        r"^(?:(?:object|person|people|vehicle|target) )?(?:commissioning|counting|tracking|following|panning|tilting|zooming|pan"
        r"|tilt|zoom|focus|count|counter|detector|detection|tracker|recognition"
        r"|absolute positioning|positioning|acceptance|range|function|regression|routine|optical) "
        r"(?:step|test|check|case)(?: [\d.]+)? ?[:.,] ",
        "",
    ),
    (
        r"^(?:(?:ok|okay|right|now|so|and),? )*(?:the )?(?:object |person |people |vehicle )?(?:detector|detection|counting|counter"
        r"|tracking|tracker|recognition|motors?|optics|zoom|pan|tilt)(?: test| check)? (?:next|now)[,.:;] (?=\w+ \w)",
        "",
    ),
    (r"(?<=\?) (?:please )?report(?: back)?(?: to me| please)?\W*$", ""),
    (
        r"^((?:is|are|was|were|has|have|do|does|did|how|what|who|where|which|any)\b[^,.;?]*?),? "
        r"(?:(?:do|would) you (?:happen to )?know|by any chance)(?=\W*$|[,.;?])",
        r"\1",
    ),
    (
        r"(?<=\w),? if (?:that(?:['’]s| is) (?:fine|cool)|(?:that|it)(?:['’]s| is) (?:ok|okay|all right|alright|possible))"
        r"(?: (?:with|by) you)?(?=\W*$)",
        "",
    ),
    (r"^(?:it|the camera|the picture|the view) needs to (?=go|come|move|point|look)", ""),
    (r",? (?:go on, )?(?:have|take) a guess\W*$", ""),
    (r"^interrogative,? ", ""),
    (r"^cam(?:era)? ?\d to (?=\w)", "go to "),
    (r" when you(?:['’]ve| have) got (?:a|one) (?:second|sec|minute|moment)\b", ""),
    (r", (?:end of )?shift change\W*$", ""),
    (r", closing (?:checks?|time)\W*$", ""),
    (r"\bright now (?=the|my|our|some)", "right now, "),
    (r"^(?-i:(?:[A-Z]\w*|[A-Z]\d+)(?: [A-Z]\w*){0,2}) to (?-i:CCTV|[Cc]ontrol|[Cc]amera(?: \w+)?), ", ""),
    (r"^control from \w+, ", ""),
    (r"\b(what (?:i|we)(?: would|['’]d)? (?:really |also )?(?:like|need|want|am after)), (?=is\b)", r"\1 "),
)
"""Patterns with the words that replace them."""
