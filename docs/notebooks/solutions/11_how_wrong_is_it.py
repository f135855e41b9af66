"""Model solutions of notebook 11, error bars and meshes that find the place."""

import numpy as np


# 11.1  Squares add up.
def answer_1(indicators):
    return np.sqrt(indicators.sum())


# 11.2  All but the law's part and what of the traction no law can give.
def answer_2(parts):
    return np.sqrt(sum(parts[name] ** 2 for name in ("stress", "skew", "jumps", "data")))


# 11.3  With s = s_h the distance of the two and the skew part vanish.
def answer_3(parts):
    return np.sqrt(sum(share ** 2 for name, share in parts.items() if name not in ("stress", "skew")))


# 11.4  The largest ones until there is enough.
def answer_4(indicators, share):
    order = np.argsort(-indicators)
    before = np.cumsum(indicators[order]) - indicators[order]
    mask = np.zeros(len(indicators), dtype=bool)
    mask[order[before < share * indicators.sum()]] = True
    return mask


# 11.5  errors ~ N^(-s), s from the last two meshes.
def answer_5(unknowns, errors, wanted):
    s = np.log(errors[-2] / errors[-1]) / np.log(unknowns[-1] / unknowns[-2])
    return unknowns[-1] * (errors[-1] / wanted) ** (1 / s)


# 11.6  The corners limit the order of uniform meshes for every degree.
answer_6 = ("c", 1)
